# SPDX-License-Identifier: GPL-3.0-or-later
import numpy as np
def load(path):
    b=open(path,'rb').read(); o=0
    def take(dt,n):
        nonlocal o
        a=np.frombuffer(b,dt,n,o); o+=a.nbytes; return a
    P,C,NV,VC,FC,TC=take('i4',6)
    m=dict(P=P,C=C,VC=VC)
    m['cells']=take('i4',4*C).reshape(C,4); m['outer']=take('u1',C); m['replaced']=take('i1',C); m['tets']=take('i4',C)
    m['tv']=take('i4',4*TC).reshape(TC,4); m['vw']=take('f8',4*NV).reshape(NV,4); m['depths']=take('f8',P); m['vol']=take('f8',C); m['stiff']=take('f8',FC)
    st=[]
    while o<len(b):
        n=int(take('i4',1)[0]); t=float(take('f8',1)[0]); x=take('f8',3*P).reshape(P,3)
        r=np.frombuffer(b,np.dtype([('f','i4'),('c','i4',2),('v','f8'),('x','f8',3)]),n,o); o+=r.nbytes
        st.append((t,x,r))
    return m,st
def slopes(x):  # (n,4,3) -> grad lambda (n,4,3), signed det
    a,b,c=x[:,1]-x[:,0],x[:,2]-x[:,0],x[:,3]-x[:,0]
    bc=np.cross(b,c); det=(a*bc).sum(1); g=np.empty_like(x)
    g[:,1]=bc;g[:,2]=np.cross(c,a);g[:,3]=np.cross(a,b);g[:,1:]/=det[:,None,None];g[:,0]=-g[:,1:].sum(1)
    return g,det
def lam(x,g,p):
    l=np.einsum('nvc,nc->nv',g,p-x[:,0]); l[:,0]+=1; return l   # g[0] = -sum, l0 = 1+g0.(p-x0)
def fold(m,cell,l):
    l=l.copy(); r=m['replaced'][cell]; w=np.where(r>=0)[0]
    if len(w):
        virt=m['cells'][cell[w],r[w]]-m['VC']; s=l[w,r[w]].copy(); l[w,r[w]]=0; l[w]+=s[:,None]*m['vw'][virt]
    return l
def state(m,x,r):
    """pair quantities and the exact nodal forces"""
    c=r['c']; X=[x[m['cells'][c[:,t]]] for t in (0,1)]
    out={}
    G=[];S=[];L=[];D=[]
    for t in (0,1):
        g,det=slopes(X[t]); G.append(np.einsum('nv,nvc->nc',m['depths'][m['cells'][c[:,t]]],g)); S.append(6*m['vol'][c[:,t]]/np.abs(det)); L.append(lam(X[t],g,r['x'])); D.append((L[t]*m['depths'][m['cells'][c[:,t]]]).sum(1))
    k=m['stiff'][r['f']]
    return dict(G=G,S=S,L=L,D=D,k=k,c=c,X=X)
def spread(m,f,cell,l,F,sign=1):
    l=fold(m,cell,l); v=m['tv'][m['tets'][cell]]
    np.add.at(f,v,sign*l[:,:,None]*F[:,None,:])
